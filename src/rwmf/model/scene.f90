!> What a scene is made of, in numbers: the effects whose loops run, and where their coefficients
!> and states stand. Runs of one scene differ only in the coefficients' values.
module rwmf_model_scene
   implicit none
   private

   public :: scene_t, term_t, add_term, is_same_scene
   public :: force_parts_t, force_parts_of
   public :: frame_term, linear_cable_term, straight_cable_term, first_wall
   public :: link_term, fuse_term

   integer, parameter :: frame_term = -1
   integer, parameter :: linear_cable_term = -2
   integer, parameter :: straight_cable_term = -3
   integer, parameter :: link_term = 2
   integer, parameter :: damper_term = 3
   integer, parameter :: inerter_term = 4
   integer, parameter :: fuse_term = 5
   integer, parameter :: hysteresis_term = 6
   integer, parameter :: vertical_term = 7
   !! numbers in the list of effects
   integer, parameter :: first_wall = 2
   !! column of the first coefficient of the wall; column 1 is 1, and 0 while the wall is held

   !> A loop over lanes that adds to the equation of motion.
   type :: term_t
      integer :: effect = 0
      !! its number in the list of effects, or one of the `_term` numbers
      integer :: n = 0
      !! how many parts it has (floors)
      integer :: law = 0
      !! which law it follows
      integer :: n_coef = 0
      !! number of its coefficients
      integer :: n_states = 0
      !! number of states of its own, or of another's that it reads
      integer :: coef = 1
      !! column of the first of these coefficients
      integer :: state = 1
      !! number of the first of these states
   end type term_t

   !> The loops of a scene in their order.
   type :: scene_t
      logical :: has_wall = .false.
      integer :: n = 2
      !! number of states
      integer :: n_coef = 1
      !! number of coefficients
      type(term_t), allocatable :: terms(:)
   end type scene_t

   !> The loops of a scene by the way in which their forces reach the wall, each with the columns of
   !> the whole scene.
   type :: force_parts_t
      logical :: is_complete = .false.
      !! nothing else exerts a force on the wall or on the ground
      logical :: has_shear_key = .false.
      !! which bears the horizontal force on the base, in the place of friction
      type(scene_t) :: through_link
      type(scene_t) :: under_corner
      !! along the chord of the corner that lifts
      type(scene_t) :: in_cable
   end type force_parts_t

contains

   !> Have two scenes the same loops with the same coefficients and states?
   pure logical function is_same_scene(one, other) result(is_same)
      type(scene_t), intent(in) :: one
      type(scene_t), intent(in) :: other

      is_same = (one%has_wall .eqv. other%has_wall) .and. one%n == other%n &
         .and. one%n_coef == other%n_coef .and. size(one%terms) == size(other%terms)
      if (.not. is_same) return
      is_same = all(one%terms%effect == other%terms%effect .and. one%terms%n == other%terms%n &
         .and. one%terms%law == other%terms%law .and. one%terms%coef == other%terms%coef &
         .and. one%terms%state == other%terms%state)
   end function is_same_scene

   !> Sort the loops of a scene. Floors, leaning columns and hinges act in more than one way.
   pure type(force_parts_t) function force_parts_of(scene) result(parts)
      type(scene_t), intent(in) :: scene
      !! on corners or without wall
      integer :: i

      parts%is_complete = .true.
      parts%through_link = scene_t(scene%has_wall, scene%n, scene%n_coef, scene%terms(:0))
      parts%under_corner = parts%through_link
      parts%in_cable = parts%through_link
      do i = 1, size(scene%terms)
         associate (term => scene%terms(i))
            select case (term%effect)
            case (linear_cable_term, straight_cable_term)
               parts%in_cable%terms = [parts%in_cable%terms, term]
            case (damper_term, inerter_term, fuse_term)
               parts%under_corner%terms = [parts%under_corner%terms, term]
            case (frame_term, link_term, hysteresis_term)
               parts%through_link%terms = [parts%through_link%terms, term]
            case (vertical_term)
               ! acts as a part of the weight
            case default
               parts%is_complete = .false.
            end select
         end associate
      end do
   end function force_parts_of

   !> Add a loop with its coefficients and states behind those that are there.
   pure subroutine add_term(scene, term)
      type(scene_t), intent(inout) :: scene
      type(term_t), intent(in) :: term
      !! without the places of its coefficients and states

      scene%terms = [scene%terms, term]
      associate (added => scene%terms(size(scene%terms)))
         added%coef = scene%n_coef + 1
         added%state = scene%n + 1
         scene%n_coef = scene%n_coef + added%n_coef
         scene%n = scene%n + added%n_states
      end associate
   end subroutine add_term

end module rwmf_model_scene
