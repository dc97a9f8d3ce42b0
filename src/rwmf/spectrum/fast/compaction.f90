!> Compaction of the lanes when ordinates become few, so that fewer blocks step.
module rwmf_spectrum_fast_compaction
   use rwmf_spectrum_fast_lane_pool, only: block_of, lane_of, lane_pool_t
   use rwmf_spectrum_fast_shared_data, only: kinds
   use rwmf_spectrum_fast_types, only: block_width, lane_block_t
   implicit none
   private

   public :: compact_blocks

contains

   !> Of each kind, move the lanes that are ready from the emptiest block to free lanes of the
   !> others, if the others have enough of them.
   pure subroutine compact_blocks(pool)
      type(lane_pool_t), intent(inout) :: pool
      integer :: n_members(size(pool%block))
      integer :: k, kind

      do k = 1, size(pool%block)
         n_members(k) = count(pool%ordinate((k - 1)*block_width + 1:k*block_width)%task /= 0)
      end do
      do kind = 1, kinds
         associate (is_same_kind => n_members > 0 .and. pool%kind == kind)
            if (count(is_same_kind) &
               <= (sum(n_members, is_same_kind) + block_width - 1)/block_width) cycle
            call dissolve_block(minloc(n_members, dim=1, mask=is_same_kind), is_same_kind, pool)
         end associate
      end do
   end subroutine compact_blocks

   !> Move the lanes of a block that are ready to free lanes of other blocks.
   pure subroutine dissolve_block(from, is_same_kind, pool)
      integer, intent(in) :: from
      logical, intent(in) :: is_same_kind(:)
      !! (blocks) has ordinates, and steps of the kind
      type(lane_pool_t), intent(inout) :: pool
      integer :: i, free

      free = 1
      do i = (from - 1)*block_width + 1, from*block_width
         if (.not. pool%block(from)%ready(lane_of(i)) > 0) cycle
         do while (pool%ordinate(free)%task /= 0 .or. .not. is_same_kind(block_of(free)) &
            .or. block_of(free) == from)
            free = free + 1
            if (free > size(pool%ordinate)) return
         end do
         call move_lane(i, free, pool)
      end do
   end subroutine dissolve_block

   !> Move an ordinate that is ready to another lane.
   pure subroutine move_lane(from, to, pool)
      integer, intent(in) :: from
      !! slot
      integer, intent(in) :: to
      !! slot
      type(lane_pool_t), intent(inout) :: pool

      pool%ordinate(to) = pool%ordinate(from)
      pool%ordinate(from)%task = 0
      call copy_lane(pool%block(block_of(from)), lane_of(from), lane_of(to), &
         pool%block(block_of(to)))
      associate (lanes => pool%block(block_of(from)), i => lane_of(from))
         lanes%ready(i) = 0
         lanes%step(i) = 1
         lanes%length_change(i) = huge(1)
      end associate
      pool%n_active(block_of(from)) = pool%n_active(block_of(from)) - 1
      pool%n_active(block_of(to)) = pool%n_active(block_of(to)) + 1
      pool%needs_update(block_of(to)) = .true.
   end subroutine move_lane

   !> Copy the state and the constants of a lane.
   pure subroutine copy_lane(source, from, to, lanes)
      type(lane_block_t), intent(in) :: source
      integer, intent(in) :: from
      !! lane
      integer, intent(in) :: to
      !! lane
      type(lane_block_t), intent(inout) :: lanes

      lanes%now%v(to) = source%now%v(from)
      lanes%now%w(to) = source%now%w(from)
      lanes%now%n(to) = source%now%n(from)
      lanes%now%n_rate(to) = source%now%n_rate(from)
      lanes%now%v_d2(to) = source%now%v_d2(from)
      lanes%error_estimate(to) = source%error_estimate(from)
      lanes%ready(to) = source%ready(from)
      lanes%v_max(to) = source%v_max(from)
      lanes%error_at_peak(to) = source%error_at_peak(from)
      lanes%step(to) = source%step(from)
      lanes%length_change(to) = source%length_change(from)
      associate (new => lanes%constants, old => source%constants)
         new%h(to) = old%h(from)
         new%inverse_h(to) = old%inverse_h(from)
         new%side(to) = old%side(from)
         new%m2(to) = old%m2(from)
         new%m3(to) = old%m3(from)
         new%damping(to) = old%damping(from)
         new%stiffness(to) = old%stiffness(from)
         new%damping_factor(to) = old%damping_factor(from)
         new%coef(to, :, :) = old%coef(from, :, :)
         new%weight(to, :) = old%weight(from, :)
      end associate
   end subroutine copy_lane

end module rwmf_spectrum_fast_compaction
