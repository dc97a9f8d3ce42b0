!> Taylor series of a frame with storeys, and of gravity on its displaced floors.
module rwmf_model_series_storey_series
   use rwmf_core_kinds, only: wp
   use rwmf_model_effects_storeys_storeys_loop, only: free_floors, no_hysteresis
   use rwmf_model_lanes, only: lane_count
   use rwmf_model_scene, only: term_t
   use rwmf_model_series_series_motion, only: highest_order, product_of, series_motion_t
   use rwmf_model_series_smooth_series, only: expand_power
   implicit none
   private

   public :: expand_floors, expand_storey_columns, locate_storeys, storey_memory

contains

   !> Number of series that the storeys keep between two coefficients.
   pure integer function storey_memory(term) result(n)
      type(term_t), intent(in) :: term
      !! term of `add_floors`

      n = 0
      if (term%law /= no_hysteresis) n = term%n*(1 + max(1, term%law - 1))
   end function storey_memory

   !> Expand the rates of the floors with states, as `add_floors`. The force of the uppermost
   !> storey, or of the link springs, adds to the moment.
   pure subroutine expand_floors(n, term, coef, y, memory, motion, rates)
      integer, intent(in) :: n
      !! number of the coefficient
      type(term_t), intent(in) :: term
      real(wp), intent(in) :: coef(lane_count, term%n_coef)
      !! coefficients as of `add_floors`
      real(wp), intent(in) :: y(lane_count, 0:highest_order, term%n_states)
      !! series of displacements [m] and velocities [m/s] of these floors, and of z [-]
      real(wp), intent(inout) :: memory(lane_count, 0:highest_order, storey_memory(term))
      !! (`storey_memory`) drift rates [m/s] and powers of z [-] of smooth storeys
      type(series_motion_t), intent(inout) :: motion
      real(wp), intent(out) :: rates(lane_count, term%n_states)
      !! coefficients n of the rates of these states
      real(wp), dimension(lane_count) :: u_roof, v_roof, force, shear, above, below
      integer :: damping, free, j, k, storeys

      storeys = term%n
      free = free_floors(term)
      damping = 3*storeys + 1
      u_roof = coef(:, 1)*motion%side*motion%u(:, n)
      v_roof = coef(:, 1)*motion%side*motion%u_rate(:, n)
      if (term%law /= no_hysteresis) call expand_smooth_storeys(n, term, &
         coef(1, 3*storeys + 2 + storeys**2), y, v_roof, motion, memory, rates)
      below = 0
      call find_shear(1, below, shear)
      do j = 1, storeys
         above = 0
         if (j < storeys) call find_shear(j + 1, below, above)
         force = shear - above
         shear = above
         do k = 1, free
            force = force + coef(:, damping + k)*y(:, n, free + k)
         end do
         damping = damping + storeys
         if (free < storeys) then
            force = force + coef(:, damping)*v_roof
            if (j == storeys) exit
         end if
         rates(:, j) = y(:, n, free + j)
         rates(:, free + j) = -(coef(:, 2*storeys + 1 + j)*force + motion%ground(:, n))
      end do
      if (free == storeys) then
         force = 0
         do j = 1, storeys
            associate (share => coef(:, term%n_coef - 2*storeys + j), &
                       stiffness => coef(:, term%n_coef - storeys + j))
               shear = stiffness*(share*u_roof - y(:, n, j))
               rates(:, storeys + j) = rates(:, storeys + j) + coef(:, 2*storeys + 1 + j)*shear
               force = force + share*shear
            end associate
         end do
      end if
      motion%roof_force(:, n) = motion%side*force/coef(:, 1)
      motion%moment(:, n) = motion%moment(:, n) - product_of(n, motion%lever, motion%roof_force)

   contains

      !> Shear of the columns of a storey, from the lowest storey up [m/s2].
      pure subroutine find_shear(storey, below, shear)
         integer, intent(in) :: storey
         real(wp), intent(inout) :: below(lane_count)
         !! displacement of the floor below; on return that of the floor above [m]
         real(wp), intent(out) :: shear(lane_count)
         real(wp) :: top(lane_count)

         top = u_roof
         if (storey <= free) top = y(:, n, storey)
         shear = coef(:, 1 + storey)*(top - below)
         below = top
         if (n == 0) shear = shear + coef(:, storeys + 1 + storey)
         if (term%law /= no_hysteresis) shear = shear + coef(:, 3*storeys + 1 + storeys**2 &
            + storey)*y(:, n, 2*free + storey)
      end subroutine find_shear

   end subroutine expand_floors

   !> Expand the rates of the states of smooth storeys.
   pure subroutine expand_smooth_storeys(n, term, coef, y, v_roof, motion, memory, rates)
      integer, intent(in) :: n
      type(term_t), intent(in) :: term
      real(wp), intent(in) :: coef(lane_count, 4*term%n)
      !! coefficients of smooth storeys, see `add_floors`
      real(wp), intent(in) :: y(lane_count, 0:highest_order, term%n_states)
      real(wp), intent(in) :: v_roof(lane_count)
      !! coefficient n of the velocity of the roof [m/s]
      type(series_motion_t), intent(in) :: motion
      real(wp), intent(inout) :: memory(lane_count, 0:highest_order, term%n, &
         1 + max(1, term%law - 1))
      !! drift rates, then powers
      real(wp), intent(inout) :: rates(lane_count, term%n_states)
      real(wp) :: powers(lane_count, 0:highest_order, max(1, term%law - 1))
      integer :: free, j, last, storeys

      storeys = term%n
      free = free_floors(term)
      last = max(1, term%law - 1)
      do j = 1, storeys
         memory(:, n, j, 1) = v_roof
         if (j <= free) memory(:, n, j, 1) = y(:, n, free + j)
         if (j > 1) memory(:, n, j, 1) = memory(:, n, j, 1) - y(:, n, free + j - 1)
         powers(:, :n, :) = memory(:, :n, j, 2:)
         call expand_power(n, term%law, coef(1, 3*storeys + j), motion%laws%negligible_state, &
            y(1, 0, 2*free + j), powers)
         memory(:, n, j, 2:) = powers(:, n, :)
         rates(:, 2*free + j) = coef(:, storeys + j)*(memory(:, n, j, 1) - coef(:, 2*storeys + j) &
            *product_of(n, memory(1, 0, j, 1), memory(1, 0, j, 1 + last)))
      end do
   end subroutine expand_smooth_storeys

   !> Add the push of the leaning columns of the storeys to floors and roof, as `add_p_delta`.
   pure subroutine expand_storey_columns(n, storeys, free, coef, y, motion, rates)
      integer, intent(in) :: n
      !! number of the coefficient
      integer, intent(in) :: storeys
      !! number of storeys
      integer, intent(in) :: free
      !! number of floors with states
      real(wp), intent(in) :: coef(lane_count, 1 + storeys + free)
      !! coefficients as of `add_p_delta`
      real(wp), intent(in) :: y(lane_count, 0:highest_order, 2*free)
      !! series of displacements [m] and velocities of these floors
      type(series_motion_t), intent(inout) :: motion
      real(wp), intent(inout) :: rates(lane_count, 2*free)
      !! coefficients n of the rates of these states; the push adds to those of the velocities
      real(wp), dimension(lane_count) :: above, below, push
      integer :: j

      below = 0
      do j = 1, storeys
         above = coef(:, 1)*motion%side*motion%u(:, n)
         if (j <= free) above = y(:, n, j)
         push = coef(:, 1 + j)*(above - below)
         below = above
         if (j > 1) rates(:, free + j - 1) = rates(:, free + j - 1) &
            - coef(:, storeys + j)*push
         if (j <= free) rates(:, free + j) = rates(:, free + j) + coef(:, storeys + 1 + j)*push
      end do
      if (free == storeys) return
      motion%column_push(:, n) = motion%side*push/coef(:, 1)
      motion%moment(:, n) = motion%moment(:, n) + product_of(n, motion%lever, motion%column_push)
   end subroutine expand_storey_columns

   !> Locate the storeys, as `locate_spring`.
   pure subroutine locate_storeys(term, n, first)
      type(term_t), intent(in) :: term
      integer, intent(out) :: n
      !! number of storeys
      integer, intent(out) :: first(3)
      !! numbers for the lowest storey; those of the others follow

      n = merge(term%n, 0, term%law /= no_hysteresis)
      first = term%coef + 3*term%n + 1 + term%n**2 + [0, 2*term%n, 3*term%n]
      first(1) = term%state + 2*free_floors(term)
   end subroutine locate_storeys

end module rwmf_model_series_storey_series
