!> What the user should know about a scene or a run that the model does not follow to its end.
module rwmf_simulation_warnings
   use rwmf_core_kinds, only: wp
   use rwmf_model_effects_vertical_motion, only: lowest_vertical
   use rwmf_model_equation, only: equation_t
   use rwmf_model_impact_rule, only: balanced_restitution, mass_ratio, restitution
   use rwmf_problem_case, only: case_t
   use rwmf_simulation_result, only: add_warning, result_t
   use rwmf_text_strings, only: real_to_text
   implicit none
   private

   public :: warn_of_chatter, warn_of_fuses, warn_of_reactions, warn_of_grazing
   public :: warn_of_short_history, warn_of_weight, broken_laws, tell_broken_laws

contains

   !> Fuses that may hold the wall up when they have been drawn out.
   subroutine warn_of_fuses(eta_y, eta_0, result)
      real(wp), intent(in) :: eta_y
      !! yield force over m_w g [-]
      real(wp), intent(in) :: eta_0
      !! prestress over m_w g, 0 without cable [-]
      type(result_t), intent(inout) :: result

      if (2*eta_y <= 1 + eta_0) return
      call add_warning(result, '2 eta_y = '//trim(real_to_text(2*eta_y))//' of &fuse exceeds ' &
         //'1 + eta_0 = '//trim(real_to_text(1 + eta_0)) &
         //', weight and prestress: the wall need not come down again')
   end subroutine warn_of_fuses

   !> A pivot that lifts or slides is not in the equation of motion.
   subroutine warn_of_reactions(result)
      type(result_t), intent(inout) :: result

      associate (reactions => result%reactions)
         if (.not. allocated(reactions%pivot_lifts)) return
         if (reactions%pivot_lifts) then
            call add_warning(result, 'the pivot reaction falls to N/(m_w g) = ' &
               //trim(real_to_text(reactions%normal_min))//' at t = ' &
               //trim(real_to_text(reactions%t_normal_min)) &
               //' s: the wall would leave the ground, which the model does not follow')
         end if
         if (allocated(reactions%t_exceeded)) then
            call add_warning(result, 'the friction demand |H|/N exceeds the friction_limit from ' &
               //'t = '//trim(real_to_text(reactions%t_exceeded)) &
               //' s: the wall would slide, which the model does not follow')
         end if
      end associate
   end subroutine warn_of_reactions

   !> Whether the wall touches its base may be decided by the errors of the run.
   subroutine warn_of_grazing(result)
      type(result_t), intent(inout) :: result

      if (.not. allocated(result%t_grazing)) return
      call add_warning(result, 'at t = '//trim(real_to_text(result%t_grazing)) &
         //' s the wall turns back on its base or hardly above it: what follows may depend ' &
         //'on the tolerance; &solver verify = .true. shows how much')
   end subroutine warn_of_grazing

   !> What follows bounces that have been averaged depends on where in a flight they end.
   subroutine warn_of_chatter(result)
      type(result_t), intent(inout) :: result

      if (.not. allocated(result%t_chatter)) return
      call add_warning(result, 'from t = '//trim(real_to_text(result%t_chatter)) &
         //' s on, bounces below the resolution of rtol are averaged (e near 1): the instants ' &
         //'of later lift-offs are not those of single bounces')
   end subroutine warn_of_chatter

   !> Rows of the history end with the motion.
   subroutine warn_of_short_history(t_end, result)
      real(wp), intent(in) :: t_end
      !! until when the case asks for it [s]
      type(result_t), intent(inout) :: result

      if (.not. (allocated(result%history) .and. result%t_end < t_end)) return
      call add_warning(result, 'the history ends at t = '//trim(real_to_text(result%t_end)) &
         //' s, when '//trim(merge('the wall overturned', 'the frame collapsed', &
         result%overturned)))
   end subroutine warn_of_short_history

   !> A pivot that lifts is not in the equation of motion.
   subroutine warn_of_weight(equation, t_end, result)
      type(equation_t), intent(in) :: equation
      real(wp), intent(in) :: t_end
      !! of the run [s]
      type(result_t), intent(inout) :: result
      real(wp) :: lowest
      !! [m/s2]

      lowest = lowest_vertical(equation%motion, t_end)
      if (equation%p%g*(1 + equation%p%eta_0) + lowest > 0) return
      call add_warning(result, 'v_g'''' falls to '//trim(real_to_text(lowest)) &
         //' m/s2, which takes all of weight and cable force: a pivot that lifts is not followed')
   end subroutine warn_of_weight

   !> Does the case itself ask to break the conservation of energy, of angular momentum?
   !>
   !> Of a rocking wall with the mass of a frame. `published` gives the frame's force another lever
   !> arm than its displacement has where theta < 0. A velocity factor below that of the momentum
   !> balance takes more than the contact at the new corner can: it damps the frame. One that
   !> exceeds it has a warning of its own.
   pure function broken_laws(case, in_grid) result(is_broken)
      type(case_t), intent(in) :: case
      logical, intent(in) :: in_grid
      !! anywhere in its `&spectrum`; otherwise in the run of the case
      logical :: is_broken(2)
      !! energy, angular momentum
      type(case_t) :: one
      real(wp), allocatable :: gamma(:)
      real(wp), allocatable :: b(:)
      integer :: i, j

      is_broken = .false.
      if (.not. (allocated(case%wall) .and. allocated(case%frame))) return
      if (case%wall%base == 'pinned') return
      one%structure_t = case%structure_t
      gamma = [mass_ratio(case)]
      b = [case%wall%b]
      if (in_grid) then
         if (allocated(case%spectrum%gamma)) gamma = case%spectrum%gamma
         if (allocated(case%spectrum%b)) b = case%spectrum%b
      end if
      is_broken(1) = case%model%formulation == 'published' .and. any(gamma > 0)
      do i = 1, size(gamma)
         one%frame%gamma = gamma(i)
         do j = 1, size(b)
            is_broken(2) = is_broken(2) .or. loses_momentum(one, atan2(b(j), case%wall%h))
         end do
      end do
   end function broken_laws

   !> What `broken_laws` found, in one line; '' for nothing.
   pure function tell_broken_laws(is_broken) result(text)
      logical, intent(in) :: is_broken(2)
      !! energy while theta < 0, angular momentum at impacts
      character(160) :: text

      text = ''
      if (.not. any(is_broken)) return
      text = 'not conserved:'
      if (is_broken(1)) text = trim(text)//" energy while theta < 0 (formulation 'published')"
      if (all(is_broken)) text = trim(text)//','
      if (is_broken(2)) text = trim(text)//' angular momentum of wall and frame at impact ' &
         //'(e < e_max)'
   end function tell_broken_laws

   !> Does an impact take more than the momentum balance of wall and frame?
   pure logical function loses_momentum(case, alpha)
      type(case_t), intent(in) :: case
      real(wp), intent(in) :: alpha
      !! slenderness [rad]

      loses_momentum = .false.
      if (.not. allocated(case%impact)) return
      if (case%impact%rule == 'coupled') return
      loses_momentum = mass_ratio(case) > 0 &
         .and. restitution(case, alpha) < balanced_restitution(case, alpha)
   end function loses_momentum

end module rwmf_simulation_warnings
